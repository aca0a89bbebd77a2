"""Liquids and gases with sourced properties."""
