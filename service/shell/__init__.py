"""Commands that work with a service, here or elsewhere: `pullfocus push`, `pullfocus render` and `pullfocus jobs`."""
