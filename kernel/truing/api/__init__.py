"""What a user calls from Python: a model is loaded, run, asked for rows and studies. Verbs are shells over it."""
