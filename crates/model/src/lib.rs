//! Force of a pneumatic muscle along a measured history: a base law and chosen effects, with exact derivatives.
