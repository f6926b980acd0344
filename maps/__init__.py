"""Maps that come with gapath; all of them are reconstructed."""
