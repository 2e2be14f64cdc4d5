"""Where the errors of a machine show, how surely, and what measurements can know of them."""
