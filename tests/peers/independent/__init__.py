"""An independent reader of htex 1, written from the text of the specification alone."""
