// SPDX-License-Identifier: Apache-2.0
// Marks of functions that compute on the CPU and on a GPU alike, from one source.
//
// A CUDA compiler makes both; to any other compiler PRESSWORK_DEVICE says nothing. PRESSWORK_INLINE: of a function that
// is always inlined; PRESSWORK_CALLED: of a large function that a card calls, so that it is compiled once.
#pragma once

#if defined(__CUDACC__)
#define PRESSWORK_DEVICE __host__ __device__
#define PRESSWORK_INLINE __host__ __device__ __forceinline__
#define PRESSWORK_CALLED __host__ __device__ __noinline__
#else
#define PRESSWORK_DEVICE
#define PRESSWORK_INLINE [[gnu::always_inline]] inline
#define PRESSWORK_CALLED
#endif
