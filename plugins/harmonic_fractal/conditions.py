"""What else must be measured before the effects can act: each condition once, for all of them."""
