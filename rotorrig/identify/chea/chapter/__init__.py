"""CHEA as published: binary genetic algorithm, ART-Kohonen clustering, and the chapter's settings."""
