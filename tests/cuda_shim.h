/* CUDA as C++ of the host: threads one after the other. */
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
struct sym_index { unsigned x, y, z; };
static thread_local sym_index blockIdx, blockDim, threadIdx;
#define __device__
#define __global__
#define __launch_bounds__(threads)
#define __noinline__ __attribute__((noinline))

/* Calls KERNEL for each thread of a grid, with arguments as cuLaunchKernel takes them. */
#define SYM_THREADS(call)                                                             \
    blockDim.x = block;                                                               \
    for (blockIdx.x = 0; blockIdx.x < grid; ++blockIdx.x)                             \
        for (threadIdx.x = 0; threadIdx.x < block; ++threadIdx.x) call
