#version 300 es
precision highp float;
precision highp int;
#define NAN uintBitsToFloat(0x7fc00000u)
#define INF uintBitsToFloat(0x7f800000u)
