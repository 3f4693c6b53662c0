"""Talk to a robot of a finished study: tell it what to do, see what it understands and does, hear what it says."""
