"""From the response of one unit to the failure probability of the system."""
