"""The verbs of `rotor`: their arguments and options, parsed and passed on to `commands`."""
