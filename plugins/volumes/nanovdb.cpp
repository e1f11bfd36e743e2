// SPDX-License-Identifier: Apache-2.0
/// nanovdb: a fog volume, or colours, from a NanoVDB file (`.nvdb`).
#include "plugins/volumes/nanovdb_file.h"
#include "plugins/volumes/vdb_volume.h"

namespace lucerna {
namespace {

class NanoVdb final : public VdbVolume {
public:
    explicit NanoVdb(const Params& params) : VdbVolume(params, read_nanovdb) {}
};

}  // namespace

const PluginInfo plugin = describe<NanoVdb>("a fog volume, or colours, from a .nvdb file");

}  // namespace lucerna
