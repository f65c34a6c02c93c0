#include "tools/lab/rd/measurement.h"

#include "format/output_file.h"
#include "tools/lab/rd/rivals.h" // bytes_in_file
#include "tools/support/checksum.h"
#include "tools/support/output_folders.h"

#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>

namespace tessera {
namespace {

// JSON has no infinity, so an infinite PSNR becomes "lossless".
Json decibels(double db) {
    return std::isfinite(db) ? Json(db) : Json("lossless");
}

Json decibels(const std::optional<double>& db) {
    return db ? decibels(*db) : Json(nullptr);
}

double decibels_from(const Json& json) {
    return json.is_string() ? std::numeric_limits<double>::infinity() : json.get<double>();
}

std::optional<double> optional_decibels_from(const Json& json) {
    return json.is_null() ? std::nullopt : std::optional(decibels_from(json));
}

std::optional<double> optional_number(const Json& json) {
    return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

Json number_or_null(const std::optional<double>& number) {
    return number ? Json(*number) : Json(nullptr);
}

Quality quality_from(const Json& json) {
    Quality q;
    q.psnr_rgb = decibels_from(json.at("psnr_rgb"));
    q.psnr_yuv = optional_decibels_from(json.at("psnr_yuv611"));
    q.psnr_worst_view = decibels_from(json.at("psnr_worst_view"));
    q.worst_s = json.at("worst_view").at("s").get<std::uint32_t>();
    q.worst_t = json.at("worst_view").at("t").get<std::uint32_t>();
    q.psnr_foreground = optional_decibels_from(json.at("psnr_foreground"));
    q.psnr_rendered = optional_decibels_from(json.at("psnr_rendered"));
    q.psnr_pu21 = optional_decibels_from(json.at("psnr_pu21"));
    q.psnr_log2 = optional_decibels_from(json.at("psnr_log2"));
    q.max_error = json.at("max_error").get<std::uint32_t>();
    return q;
}

Json to_json(const Quality& q) {
    return {{"psnr_rgb", decibels(q.psnr_rgb)},
            {"psnr_yuv611", decibels(q.psnr_yuv)},
            {"psnr_worst_view", decibels(q.psnr_worst_view)},
            {"worst_view", {{"s", q.worst_s}, {"t", q.worst_t}}},
            {"psnr_foreground", decibels(q.psnr_foreground)},
            {"psnr_rendered", decibels(q.psnr_rendered)},
            {"psnr_pu21", decibels(q.psnr_pu21)},
            {"psnr_log2", decibels(q.psnr_log2)},
            {"max_error", q.max_error}};
}

std::string word(const Json& key, const char* name) {
    std::string text = key.contains(name) ? key.at(name).get<std::string>() : "";
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.')
            c = '-';
    return text;
}

} // namespace

Json to_json(const Measurement& m) {
    Json json = {{"codec", m.codec}, {"setting", m.setting}};
    if (!m.failed.empty()) {
        json["failed"] = m.failed;
        return json;
    }
    json["bytes"] = m.bytes;
    json["bits_per_texel"] = m.bits_per_texel;
    json["quality"] = to_json(m.quality);
    json["encode_MBps"] = m.encode_mbs;
    json["decode_MBps"] = m.decode_mbs;
    json["bytes_for_one_texel"] = number_or_null(m.texel_bytes);
    json["bytes_for_one_view"] = number_or_null(m.view_bytes);
    json["note"] = m.note;
    json["cached"] = m.cached;
    return json;
}

std::optional<Measurement> measurement_from_json(const Json& json) {
    try {
        Measurement m;
        m.codec = json.at("codec").get<std::string>();
        m.setting = json.at("setting").get<std::string>();
        m.bytes = json.at("bytes").get<std::uint64_t>();
        m.bits_per_texel = json.at("bits_per_texel").get<double>();
        m.quality = quality_from(json.at("quality"));
        m.encode_mbs = json.at("encode_MBps").get<double>();
        m.decode_mbs = json.at("decode_MBps").get<double>();
        m.texel_bytes = optional_number(json.at("bytes_for_one_texel"));
        m.view_bytes = optional_number(json.at("bytes_for_one_view"));
        m.note = json.at("note").get<std::string>();
        return m;
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

std::string MeasurementCache::path_of(const Json& key) const {
    const std::string text = key.dump();
    char crc[16];
    std::snprintf(crc, sizeof crc, "%08x", checksum(std::as_bytes(std::span(text))));
    return folder_ + "/" + word(key, "codec") + "_" + word(key, "setting") + "_" + crc + ".json";
}

std::optional<Measurement> MeasurementCache::find(const Json& key) const {
    const auto bytes = bytes_in_file(path_of(key));
    if (!bytes.ok())
        return std::nullopt;
    const auto* text = reinterpret_cast<const char*>(bytes->data());
    const Json json = Json::parse(text, text + bytes->size(), nullptr, false);
    if (!json.is_object() || !json.contains("key") || json.at("key") != key)
        return std::nullopt;
    auto measurement = measurement_from_json(json.value("measurement", Json()));
    if (measurement)
        measurement->cached = true;
    return measurement;
}

Status MeasurementCache::keep(const Json& key, const Measurement& measurement) const {
    std::error_code error;
    std::filesystem::create_directories(to_path(folder_), error);
    if (error)
        return {ErrorCode::io, folder_ + ": cannot be created: " + error.message()};
    const Json json = {{"key", key}, {"measurement", to_json(measurement)}};
    const std::string text = json.dump(1) + "\n";
    return write_bytes(path_of(key), std::as_bytes(std::span(text)));
}

} // namespace tessera
