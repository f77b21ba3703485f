"""What the site needs beside Sphinx: equations without a network, pages of source files."""
