//! Statistics of rating studies: repeated measures, paired comparisons, regression, power. Independent of textures and files.
#![forbid(unsafe_code)]
