"""One design under many circumstances: what varies, how it is run, what is made of the results."""
