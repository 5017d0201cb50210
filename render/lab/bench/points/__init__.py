"""The points bench: errors of sample patterns on the pupil and the sensor."""
