// SPDX-License-Identifier: Apache-2.0
/// Loops over arrays for vector instructions.
#pragma once

/// Before a function with a loop over arrays: it is compiled twice, for eight floats at a time
/// where the processor has them, with the same results. What it calls must be inline. Not under the
/// thread sanitizer, which is not ready yet when a program chooses between the two. Functions in
/// headers have a macro of their own: Clang 14 would define the choice in each object file.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#define LUCERNA_VECTORIZED [[gnu::target_clones("avx2", "default")]]
#else
#define LUCERNA_VECTORIZED
#endif
#if defined(__clang__)
#define LUCERNA_VECTORIZED_INLINE
#else
#define LUCERNA_VECTORIZED_INLINE LUCERNA_VECTORIZED
#endif
