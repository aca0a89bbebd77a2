"""Flow through a rough contact: conductivity, leak integral, gases, fluid that opens the gap."""
