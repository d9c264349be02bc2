"""What a calculation says of itself: fields, error sources, goals, and the model that joins them."""
