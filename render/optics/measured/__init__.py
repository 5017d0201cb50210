"""Lenses from what people measure of them: MTF charts, calibrated distortion, STMaps and photographs of bokeh."""
