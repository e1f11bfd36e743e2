// SPDX-License-Identifier: Apache-2.0
/// openvdb: a fog volume, or colours, from an OpenVDB file (`.vdb`).
#include "plugins/volumes/openvdb_file.h"
#include "plugins/volumes/vdb_volume.h"

namespace lucerna {
namespace {

class OpenVdb final : public VdbVolume {
public:
    explicit OpenVdb(const Params& params) : VdbVolume(params, read_openvdb) {}
};

}  // namespace

const PluginInfo plugin = describe<OpenVdb>("a fog volume, or colours, from a .vdb file");

}  // namespace lucerna
