"""Gaussian splats in traced and accumulated pictures: drawn between the layers of surfaces. Loaded where a scene has splats."""
