"""What each verb does, one file a verb: read the inputs, call one stage, write one file, say one line."""
