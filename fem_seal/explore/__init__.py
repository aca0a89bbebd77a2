"""The live page of a case: sliders, and what follows from them."""
