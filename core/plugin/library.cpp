// SPDX-License-Identifier: Apache-2.0
#include "core/plugin/library.h"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>
#include <xmmintrin.h>

#include <fstream>

namespace lucerna {

namespace fs = std::filesystem;

fs::path core_library_folder() {
    Dl_info info{};
    dladdr(reinterpret_cast<const void*>(&core_library_folder), &info);
    std::error_code ignored;
    const fs::path path = info.dli_fname ? info.dli_fname : "";
    const fs::path resolved = fs::weakly_canonical(path, ignored);
    return (ignored ? path : resolved).parent_path();
}

namespace {

/// The loader maps what the headers promise: a file that was cut short would end the process with
/// SIGBUS inside dlopen, so the promise is checked first.
void check_elf(const fs::path& library) {
    const auto damaged = [&](const char* what) {
        return PluginError(fmt::format("{} is not a usable library: {}\n  build it again",
                                       library.string(), what));
    };
    std::error_code failed;
    const auto size = static_cast<std::uint64_t>(fs::file_size(library, failed));
    std::ifstream file(library, std::ios::binary);
    if (failed || !file) throw damaged("it cannot be read");

    Elf64_Ehdr header{};
    if (!file.read(reinterpret_cast<char*>(&header), sizeof header) ||
        std::string_view(reinterpret_cast<const char*>(header.e_ident), SELFMAG) != ELFMAG) {
        throw damaged("it is not an ELF file");
    }
    if (header.e_ident[EI_CLASS] != ELFCLASS64) throw damaged("it is not a 64-bit library");
    const std::uint64_t sections =
        header.e_shoff + std::uint64_t{header.e_shnum} * header.e_shentsize;
    if (sections > size) throw damaged("it is truncated");
    for (unsigned i = 0; i < header.e_phnum; ++i) {
        Elf64_Phdr segment{};
        const std::uint64_t at = header.e_phoff + std::uint64_t{i} * header.e_phentsize;
        file.seekg(static_cast<std::streamoff>(at));
        if (!file.read(reinterpret_cast<char*>(&segment), sizeof segment) ||
            (segment.p_type == PT_LOAD && segment.p_offset + segment.p_filesz > size)) {
            throw damaged("it is truncated");
        }
    }
}

void check_info(const PluginInfo& info, const fs::path& library, std::string_view kind) {
    if (info.magic != plugin_magic || info.size != sizeof(PluginInfo) ||
        std::string_view(info.abi) != lucerna_contract_abi) {
        const std::string theirs = info.magic == plugin_magic ? info.abi : "unknown";
        throw PluginError(
            fmt::format("{} was built for another Lucerna: build it again\n  it wants:  {}\n"
                        "  this is:   {}",
                        library.string(), theirs, lucerna_contract_abi));
    }
    if (info.kind != kind) {
        throw PluginError(fmt::format("{} is a plugin for <{}>, not for <{}>", library.string(),
                                      info.kind, kind));
    }
}

}  // namespace

const PluginInfo& open_plugin(const fs::path& library, std::string_view kind) {
    check_elf(library);
    // A library linked with -ffast-math switches the thread that opens it to flush-to-zero.
    const unsigned mode = _mm_getcsr();
    void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    constexpr unsigned status_flags = 0x3f;
    const bool mode_changed = ((mode ^ _mm_getcsr()) & ~status_flags) != 0;
    _mm_setcsr(mode);
    if (!handle) {
        throw PluginError(fmt::format("{} cannot be opened: {}\n  build it again for this Lucerna",
                                      library.string(), dlerror()));
    }
    if (mode_changed) {
        throw PluginError(fmt::format(
            "{} changes how the processor rounds: build it without -ffast-math", library.string()));
    }
    const auto* info = static_cast<const PluginInfo*>(dlsym(handle, "plugin"));
    if (!info) {
        throw PluginError(
            fmt::format("{} exports no plugin: it should end with\n"
                        "  const PluginInfo plugin = describe<T>(\"…\");",
                        library.string()));
    }
    check_info(*info, library, kind);
    return *info;
}

}  // namespace lucerna
