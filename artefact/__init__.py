"""The material standard: freeform patches, datum spheres, datum plane and the body they sit on."""
