"""Every figure. Nothing outside of this folder imports matplotlib."""
