"""Expert motions: a model-based controller makes them, clips keep them, the validator judges them."""
