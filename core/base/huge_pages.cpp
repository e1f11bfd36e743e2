// SPDX-License-Identifier: Apache-2.0
#include "core/base/huge_pages.h"

#include <sys/mman.h>

#include <cstdlib>

namespace lucerna {

void* allocate_huge_pages(std::size_t bytes) {
    void* const memory = std::aligned_alloc(huge_page, bytes);
    if (!memory) throw std::bad_alloc();
#if defined(MADV_HUGEPAGE)
    madvise(memory, bytes, MADV_HUGEPAGE);  // advice: that it can fail does not matter
#endif
    return memory;
}

void free_huge_pages(void* memory) { std::free(memory); }

}  // namespace lucerna
