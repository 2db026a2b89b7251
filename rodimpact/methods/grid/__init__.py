"""The method "finite-difference": states on a staggered grid."""
