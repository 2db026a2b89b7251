"""Piles in soil: how they rest, blow after blow, and their bearing graph.

Begin with `blows`, which strikes a pile; `resting` puts it to rest, by the equilibrium
of `statics`; `bearing` draws on both.
"""
