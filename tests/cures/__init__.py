"""Every refusal of a file, with the bad file that brings it and the cure that its words name."""
