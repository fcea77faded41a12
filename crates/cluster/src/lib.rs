//! Region growing over any graph of uncertain normals, with the threshold interval on which the result holds
