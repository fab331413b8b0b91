"""Commands behind the verbs, one file each: read the inputs, call one stage, write one file, print the result."""
