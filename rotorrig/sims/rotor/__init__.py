"""Rotor model of the identifier: finite elements, modes, steady and swept responses, nonlinear force laws."""
