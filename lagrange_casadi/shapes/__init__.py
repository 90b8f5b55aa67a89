"""What is drawn of a mechanism, as places and shapes; and what all pictures share."""
