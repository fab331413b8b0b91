"""Acquisition and identification for a rotor test rig; the README's Conventions hold throughout."""
