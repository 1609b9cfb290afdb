"""What each of some mistakes in a script of a rocking block costs."""
