#pragma once
// The algorithms of "Factoring of Multiple Function Wavelet Production Sampling" (Chen, Gao, Huang)
// as published, errors of print corrected: hash tables of L2-normalised Haar coefficients, to be
// read, and to hold faster ways against. What the toolkit itself multiplies with is
// <wavelet/product/synchronous_product.h>.
//
//     equation 17             CoefficientSet, coefficient_set(), image_of()
//     theorem of section 4.2  product_integral(), integral_by_theorem()
//     cases of sections 4.2   tripling_coefficient(), scaling_tripling_coefficient()
//     and 4.4
//     Table 1, PSUM           ParentSums
//     Table 2, CSUM           ChildrenSums
//     Table 3, PRODUCT        Product::coefficient(), multiply()
//     Table 4, OPPRODUCT      Product::average()
//     equations 14 to 16      multiply() of many, inner_product(), factored_integral()
//
// All functions are scalar (one channel) and live on the unit square; `T` is float or double.

#include <wavelet/reference/basis.h>
#include <wavelet/reference/coefficient_set.h>
#include <wavelet/reference/product.h>
#include <wavelet/reference/square.h>
