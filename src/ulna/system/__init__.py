"""What depends on the operating system, in one place: folders, files that are whole or absent, locks across forks."""
