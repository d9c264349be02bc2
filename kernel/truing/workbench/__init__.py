"""The workbench of ``calc serve``: pages on the user's own machine over the same calls and files as the command line.

The server holds no model. What needs one (``tasks``) runs in worker processes (``workers``), which can hang, crash or
print without harm; routes put together what they answer. Nothing is kept anywhere but in the folder that is served.
"""
