#include "format/container/file_coding.h"

#include "format/container/syntax.h"
#include "format/tile/features.h"

namespace tessera {

Result<CodingParameters> coding_of(const ContainerReader& file) {
    const FileHeader& header = file.header();
    const bool corrections = (header.required_features & feature_corrections) != 0;
    TESSERA_TRY_ASSIGN(
        const CodingParameters coding,
        read_coding_parameters(file.codec_parameters(), header.desc.channels, corrections));
    TESSERA_TRY(check_features(coding, header.required_features));
    return coding;
}

} // namespace tessera
