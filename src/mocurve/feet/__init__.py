"""Feet: which joints they are, when they stand, and how much they slide.

planted:  joints of feet that rest anywhere, frame by frame: what reduction and joining take care of.
legs:     hip, knee, ankle and ball of both legs, found by name and shape.
contacts: spans in which the ball or the heel stands on the floor, and where: what is locked, and edited by hand.
skate:    how much feet slide in such spans.
"""
