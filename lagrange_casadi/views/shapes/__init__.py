"""Places and shapes of a mechanism's picture; and the parts that all pictures share."""
