//! Tests beside libraries that answer the same questions in other ways, and the program that prints golden
//! digests.
