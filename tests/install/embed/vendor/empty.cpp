// A library without content.
