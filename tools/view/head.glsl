#version 300 es
precision highp float;
precision highp int;

const float pi = 3.14159265358979;

