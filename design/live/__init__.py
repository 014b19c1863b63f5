"""Live shaping: at each event the rest of the command is solved anew from the state then."""
