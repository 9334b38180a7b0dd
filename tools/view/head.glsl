precision highp float;
precision highp int;

const float pi = 3.14159265358979;


/// Of textures that hold trees, in this fragment.
float accesses = 0.0;
