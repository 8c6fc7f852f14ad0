"""The command line: one module a subcommand, each with one function whose arguments are the command's."""
