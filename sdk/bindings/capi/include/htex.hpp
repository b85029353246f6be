/* htex.hpp: libhtex for C++17. Objects free themselves and can be moved. No function throws an
 * error of htex: a call that can fail returns a status, or a Result with either a value or a status
 * and its text.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef HTEX_HPP
#define HTEX_HPP

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "htex.h"

namespace htex {

using Motion = htex_motion;
using Finger = htex_finger;
using Condition = htex_condition;
using Band = htex_band;
using Reader = htex_reader;
using Files = htex_files;
using DeviceCounts = htex_device_counts;

/* Returns a motion whose position and place are unknown. */
inline Motion motion(double speed_mm_s, double force_n) noexcept
{
    return {sizeof(Motion), speed_mm_s, force_n, NAN, NAN, NAN};
}

/* The status of a call, and the text of its error. The text is empty on success. */
struct Status {
    htex_status code = HTEX_STATUS_OK;
    std::string text;

    explicit operator bool() const noexcept { return code == HTEX_STATUS_OK; }
};

inline Status status_of(htex_status code)
{
    return code == HTEX_STATUS_OK ? Status{} : Status{code, htex_last_error()};
}

/* Returns the meaning of a status, in English. */
inline const char *text_of(htex_status code) noexcept
{
    return htex_status_text(code);
}

/* Sets the function that receives messages; see htex_set_log. */
inline htex_status set_log(htex_log_callback callback, void *context = nullptr) noexcept
{
    return htex_set_log(callback, context);
}

/* Frees everything that the library holds; see htex_shutdown. Calls on remaining objects then
 * fail. */
inline htex_status shutdown() noexcept
{
    return htex_shutdown();
}

/* The value that a call returns, or the status of a call that failed. */
template <typename T> class Result {
public:
    Result(T value) : value_(std::move(value)) {}
    Result(Status status) : status_(std::move(status)) {}

    explicit operator bool() const noexcept { return value_.has_value(); }
    T &operator*() noexcept { return *value_; }
    const T &operator*() const noexcept { return *value_; }
    T *operator->() noexcept { return &*value_; }
    const T *operator->() const noexcept { return &*value_; }
    const Status &status() const noexcept { return status_; }

private:
    std::optional<T> value_;
    Status status_;
};

namespace detail {

/* Owns a handle, and frees it once. */
template <typename Handle, htex_status (*Free)(Handle)> class Owned {
public:
    Owned() noexcept = default;
    explicit Owned(Handle handle) noexcept : handle_(handle) {}
    Owned(Owned &&other) noexcept : handle_(std::exchange(other.handle_, Handle{0})) {}
    Owned &operator=(Owned &&other) noexcept
    {
        std::swap(handle_, other.handle_);
        return *this;
    }
    Owned(const Owned &) = delete;
    Owned &operator=(const Owned &) = delete;
    ~Owned()
    {
        if (handle_.id != 0)
            Free(handle_);
    }
    Handle get() const noexcept { return handle_; }

private:
    Handle handle_{0};
};

/* Returns the text that a function writes. */
template <typename Call> Result<std::string> text(Call call)
{
    size_t length = 0;
    if (Status status = status_of(call(nullptr, 0, &length)); !status)
        return status;
    std::string text(length + 1, '\0');
    if (Status status = status_of(call(text.data(), text.size(), &length)); !status)
        return status;
    text.resize(length);
    return text;
}

} /* namespace detail */

/* Options for making a voice; see htex_voice_options. */
struct VoiceOptions {
    std::optional<std::string> model;
    double rate_hz = 0.0;
    uint64_t seed = 0;
    std::optional<Motion> motion;
    std::optional<std::string> synthesis;
    double gain = 0.0;  /* 0: 1 */
    double limit = 0.0; /* in the asset's unit; 0: none */
    uint32_t envelope_bands = 0;
    bool frequency_scaling = true;
    bool level_scaling = true;
    bool contact = true;
    double ceiling = 0.0;
    bool fluctuation = false;
};

/* Level and mean frequency of what a voice played since the last call; see htex_voice_envelope. */
struct Envelope {
    double level_rms = 0.0;
    double centroid_hz = 0.0;
    uint64_t frames = 0;
};

/* A texture that is playing; see htex_voice. [one thread at a time] */
class Voice {
public:
    Voice() noexcept = default;

    /* [real-time] Sets the motion of the finger. Returns only the status code: copying the text
     * of an error would allocate. */
    htex_status set_motion(const Motion &motion) noexcept
    {
        return htex_voice_set_motion(handle_.get(), &motion);
    }
    /* [real-time] */
    htex_status render(float *out, size_t frames) noexcept
    {
        return htex_voice_render(handle_.get(), out, frames);
    }
    /* [real-time] */
    htex_status render_path(const Motion *motions, size_t motions_len, float *out, size_t frames) noexcept
    {
        return htex_voice_render_path(handle_.get(), motions, motions_len, out, frames);
    }
    /* [real-time] Renders samples, multiplies them by `gain` and adds them to `out`. */
    htex_status render_add(float *out, size_t frames, float gain) noexcept
    {
        return htex_voice_render_add(handle_.get(), out, frames, gain);
    }
    /* [real-time] */
    htex_status set_gain(double gain) noexcept { return htex_voice_set_gain(handle_.get(), gain); }
    /* [real-time] Returns whether the voice is silent; false if there is no voice. */
    bool is_silent() const noexcept
    {
        uint32_t silent = 0;
        htex_voice_is_silent(handle_.get(), &silent);
        return silent != 0;
    }
    /* [real-time] Writes the level and mean frequency of what was rendered since the last call.
     * `bands_len` must be the voice's number of bands, or 0. */
    htex_status envelope(Envelope &out, double *bands = nullptr, size_t bands_len = 0) noexcept
    {
        htex_envelope envelope{};
        envelope.size = sizeof envelope;
        htex_status code = htex_voice_envelope(handle_.get(), &envelope, bands, bands_len);
        if (code == HTEX_STATUS_OK)
            out = {envelope.level_rms, envelope.centroid_hz, envelope.frames};
        return code;
    }
    /* Returns the edges of the bands of `envelope`, Hz. `bands` must be the voice's number of
     * bands. */
    Result<std::vector<double>> envelope_edges(size_t bands) const
    {
        std::vector<double> edges_hz(bands + 1);
        htex_status code = htex_voice_envelope_edges(handle_.get(), edges_hz.data(), edges_hz.size());
        if (Status status = status_of(code); !status)
            return status;
        return edges_hz;
    }
    /* Restarts the voice; see htex_voice_reset. */
    Status reset(const std::optional<Motion> &motion = {})
    {
        return status_of(htex_voice_reset(handle_.get(), motion ? &*motion : nullptr));
    }
    /* Returns the id of the model that plays. */
    Result<std::string> model() const
    {
        return detail::text([&](char *out, size_t capacity, size_t *length) {
            return htex_voice_model(handle_.get(), out, capacity, length);
        });
    }
    Result<std::string> coverage(const Motion &motion) const
    {
        return detail::text([&](char *out, size_t capacity, size_t *length) {
            return htex_voice_coverage(handle_.get(), &motion, out, capacity, length);
        });
    }

private:
    friend class Texture;
    explicit Voice(htex_voice handle) noexcept : handle_(handle) {}
    detail::Owned<htex_voice, htex_voice_free> handle_;
};

/* The engine that runs WASM modules; see htex_open_options. */
enum class Engine : uint32_t {
    off = HTEX_ENGINE_OFF,
    checked = HTEX_ENGINE_CHECKED,
    with_signals = HTEX_ENGINE_SIGNALS,
};

/* Options for opening an asset or a scene; see htex_open_options. */
struct OpenOptions {
    std::vector<std::string> plugins;
    std::vector<std::vector<uint8_t>> modules;
    Engine engine = Engine::off;
    std::optional<std::string> cache;
    bool embedded = true;
    bool installed = false;
    /* Public keys, of which one must have signed each texture; none to require no signature. */
    std::vector<std::string> only_signed_by;
    /* The contents of the file with the signature, for what has no path. */
    std::vector<uint8_t> signature;

    template <typename Call> htex_status with(Call call) const
    {
        std::vector<const char *> files;
        for (const std::string &plugin : plugins)
            files.push_back(plugin.c_str());
        std::vector<htex_bytes> bytes;
        for (const std::vector<uint8_t> &module : modules)
            bytes.push_back({module.data(), module.size()});
        htex_open_options options{};
        options.size = sizeof options;
        options.engine = static_cast<uint32_t>(engine);
        options.plugins = files.data();
        options.plugins_len = files.size();
        options.modules = bytes.data();
        options.modules_len = bytes.size();
        options.cache = cache ? cache->c_str() : nullptr;
        options.no_embedded = !embedded;
        options.installed = installed;
        std::vector<const char *> keys;
        for (const std::string &key : only_signed_by)
            keys.push_back(key.c_str());
        options.only_signed_by = keys.data();
        options.only_signed_by_len = keys.size();
        options.signature = {signature.data(), signature.size()};
        return call(&options);
    }
};

/* An open asset, which makes voices. [any thread] */
class Texture {
public:
    Texture() noexcept = default;

    static Result<Texture> open(const std::string &path, const OpenOptions &options = {})
    {
        htex_asset asset{};
        htex_status code = options.with(
            [&](const htex_open_options *open) { return htex_asset_open(path.c_str(), open, &asset); });
        return made(code, asset);
    }
#ifdef _WIN32
    static Result<Texture> open(const std::wstring &path, const OpenOptions &options = {})
    {
        htex_asset asset{};
        htex_status code = options.with([&](const htex_open_options *open) {
            return htex_asset_open_wide(reinterpret_cast<const uint16_t *>(path.c_str()), open, &asset);
        });
        return made(code, asset);
    }
#endif
    /* Opens an asset whose bytes come from the program's own functions; see
     * htex_asset_open_reader. */
    static Result<Texture> open(const Reader &reader, const OpenOptions &options = {})
    {
        htex_asset asset{};
        htex_status code = options.with(
            [&](const htex_open_options *open) { return htex_asset_open_reader(&reader, open, &asset); });
        return made(code, asset);
    }
    static Result<Texture> from_bytes(const uint8_t *bytes, size_t len, const OpenOptions &options = {})
    {
        htex_asset asset{};
        htex_status code = options.with(
            [&](const htex_open_options *open) { return htex_asset_from_bytes(bytes, len, open, &asset); });
        return made(code, asset);
    }

    Result<Voice> voice(const VoiceOptions &options = {}) const
    {
        htex_voice_options c{};
        c.size = sizeof c;
        c.model = options.model ? options.model->c_str() : nullptr;
        c.rate_hz = options.rate_hz;
        c.seed = options.seed;
        c.motion = options.motion ? &*options.motion : nullptr;
        c.synthesis = options.synthesis ? options.synthesis->c_str() : nullptr;
        c.gain = options.gain;
        c.limit = options.limit;
        c.envelope_bands = options.envelope_bands;
        c.no_frequency_scaling = !options.frequency_scaling;
        c.no_level_scaling = !options.level_scaling;
        c.no_contact = !options.contact;
        c.ceiling = options.ceiling;
        c.fluctuation = options.fluctuation;
        htex_voice voice{};
        if (Status status = status_of(htex_voice_new(handle_.get(), &c, &voice)); !status)
            return status;
        return Voice(voice);
    }

    Result<std::string> manifest_json() const
    {
        return detail::text([&](char *out, size_t capacity, size_t *length) {
            return htex_asset_manifest_json(handle_.get(), out, capacity, length);
        });
    }
    Result<std::string> name() const
    {
        return detail::text([&](char *out, size_t capacity, size_t *length) {
            return htex_asset_name(handle_.get(), out, capacity, length);
        });
    }
    /* Returns the frequency band of the asset's spectra. */
    Result<Band> band() const
    {
        Band band{};
        if (Status status = status_of(htex_asset_band(handle_.get(), &band)); !status)
            return status;
        return band;
    }
    /* Returns the level at which a representation plays: RMS, in the asset's unit. */
    Result<double> level_rms(const std::optional<std::string> &model = {}, const std::optional<Motion> &at = {}) const
    {
        double level_rms = 0.0;
        htex_status code = htex_asset_level_rms(handle_.get(), model ? model->c_str() : nullptr,
                                                at ? &*at : nullptr, &level_rms);
        if (Status status = status_of(code); !status)
            return status;
        return level_rms;
    }
    Result<std::string> unit() const
    {
        return detail::text([&](char *out, size_t capacity, size_t *length) {
            return htex_asset_unit(handle_.get(), out, capacity, length);
        });
    }
    /* Returns the model id of each representation. */
    Result<std::vector<std::string>> models() const
    {
        size_t count = 0;
        if (Status status = status_of(htex_asset_representation_count(handle_.get(), &count)); !status)
            return status;
        std::vector<std::string> models;
        for (size_t i = 0; i < count; i++) {
            Result<std::string> model = detail::text([&](char *out, size_t capacity, size_t *length) {
                return htex_asset_representation_model(handle_.get(), i, out, capacity, length);
            });
            if (!model)
                return model.status();
            models.push_back(std::move(*model));
        }
        return models;
    }
    Result<std::vector<Condition>> conditions() const
    {
        size_t count = 0;
        if (Status status = status_of(htex_asset_condition_count(handle_.get(), &count)); !status)
            return status;
        std::vector<Condition> conditions(count);
        for (size_t i = 0; i < count; i++)
            if (Status status = status_of(htex_asset_condition(handle_.get(), i, &conditions[i])); !status)
                return status;
        return conditions;
    }
    /* Returns the spectrum that a recording of the voice would show; see htex_asset_magnitude. */
    Result<std::vector<double>> magnitude(const std::vector<double> &frequency_hz,
                                          const std::optional<std::string> &model = {},
                                          const std::optional<Motion> &at = {}) const
    {
        std::vector<double> magnitude(frequency_hz.size());
        htex_status code = htex_asset_magnitude(handle_.get(), model ? model->c_str() : nullptr,
                                                at ? &*at : nullptr, frequency_hz.data(),
                                                magnitude.data(), magnitude.size());
        if (Status status = status_of(code); !status)
            return status;
        return magnitude;
    }

private:
    friend class Library;
    explicit Texture(htex_asset handle) noexcept : handle_(handle) {}
    static Result<Texture> made(htex_status code, htex_asset asset)
    {
        if (Status status = status_of(code); !status)
            return status;
        return Texture(asset);
    }
    detail::Owned<htex_asset, htex_asset_free> handle_;
};

/* An open library: a file with any number of textures. [any thread] */
class Library {
public:
    Library() noexcept = default;

    static Result<Library> open(const std::string &path)
    {
        htex_library library{};
        return made(htex_library_open(path.c_str(), &library), library);
    }
#ifdef _WIN32
    static Result<Library> open(const std::wstring &path)
    {
        htex_library library{};
        return made(htex_library_open_wide(reinterpret_cast<const uint16_t *>(path.c_str()), &library), library);
    }
#endif
    /* Opens a library whose bytes come from the program's own functions; see
     * htex_library_open_reader. */
    static Result<Library> open(const Reader &reader)
    {
        htex_library library{};
        return made(htex_library_open_reader(&reader, &library), library);
    }
    static Result<Library> from_bytes(const uint8_t *bytes, size_t len)
    {
        htex_library library{};
        return made(htex_library_from_bytes(bytes, len, &library), library);
    }

    /* Opens a texture of the library. Reads only the parts of the file that it needs. */
    Result<Texture> texture(const std::string &name, const OpenOptions &options = {}) const
    {
        htex_asset asset{};
        htex_status code = options.with([&](const htex_open_options *open) {
            return htex_library_asset(handle_.get(), name.c_str(), open, &asset);
        });
        return Texture::made(code, asset);
    }
    Result<std::string> name() const
    {
        return detail::text([&](char *out, size_t capacity, size_t *length) {
            return htex_library_name(handle_.get(), out, capacity, length);
        });
    }
    Result<uint64_t> count() const
    {
        uint64_t count = 0;
        if (Status status = status_of(htex_library_count(handle_.get(), &count)); !status)
            return status;
        return count;
    }
    Result<size_t> page_count() const
    {
        size_t count = 0;
        if (Status status = status_of(htex_library_page_count(handle_.get(), &count)); !status)
            return status;
        return count;
    }
    /* Returns the entries of an index page as JSON; see htex_library_page_json. */
    Result<std::string> page_json(size_t page) const
    {
        return detail::text([&](char *out, size_t capacity, size_t *length) {
            return htex_library_page_json(handle_.get(), page, out, capacity, length);
        });
    }
    Result<std::string> entry_json(const std::string &name) const
    {
        return detail::text([&](char *out, size_t capacity, size_t *length) {
            return htex_library_entry_json(handle_.get(), name.c_str(), out, capacity, length);
        });
    }

private:
    explicit Library(htex_library handle) noexcept : handle_(handle) {}
    static Result<Library> made(htex_status code, const htex_library &library)
    {
        if (Status status = status_of(code); !status)
            return status;
        return Library(library);
    }
    detail::Owned<htex_library, htex_library_free> handle_;
};

/* A scene that plays; see htex_scene. [one thread at a time] */
class Scene {
public:
    Scene() noexcept = default;

    static Result<Scene> open(const std::string &path, double rate_hz = 0.0, const OpenOptions &options = {})
    {
        return made(rate_hz, options, [&](const htex_open_options *open, const htex_scene_options *of, htex_scene *out) {
            return htex_scene_open(path.c_str(), open, of, out);
        });
    }
#ifdef _WIN32
    static Result<Scene> open(const std::wstring &path, double rate_hz = 0.0, const OpenOptions &options = {})
    {
        return made(rate_hz, options, [&](const htex_open_options *open, const htex_scene_options *of, htex_scene *out) {
            return htex_scene_open_wide(reinterpret_cast<const uint16_t *>(path.c_str()), open, of, out);
        });
    }
#endif
    /* Opens a scene file in memory; the program supplies the other files of the scene. */
    static Result<Scene> from_bytes(const uint8_t *bytes, size_t len, const Files &files, double rate_hz = 0.0,
                                    const OpenOptions &options = {})
    {
        return made(rate_hz, options, [&](const htex_open_options *open, const htex_scene_options *of, htex_scene *out) {
            return htex_scene_from_bytes(bytes, len, &files, open, of, out);
        });
    }
    Result<std::string> plan_json() const
    {
        return detail::text([&](char *out, size_t capacity, size_t *length) {
            return htex_scene_plan_json(handle_.get(), out, capacity, length);
        });
    }
    double rate_hz() const noexcept
    {
        double rate_hz = NAN;
        htex_scene_rate_hz(handle_.get(), &rate_hz);
        return rate_hz;
    }
    /* [real-time] */
    htex_status set_finger(const Finger &finger) noexcept
    {
        return htex_scene_set_finger(handle_.get(), &finger);
    }
    /* [real-time] */
    htex_status render(float *out, size_t frames, size_t &rendered) noexcept
    {
        return htex_scene_render(handle_.get(), out, frames, &rendered);
    }
    /* [real-time] */
    htex_status stop() noexcept { return htex_scene_stop(handle_.get()); }

private:
    explicit Scene(htex_scene handle) noexcept : handle_(handle) {}
    template <typename Call> static Result<Scene> made(double rate_hz, const OpenOptions &options, Call call)
    {
        htex_scene_options scene_options{};
        scene_options.size = sizeof scene_options;
        scene_options.rate_hz = rate_hz;
        htex_scene scene{};
        htex_status code = options.with(
            [&](const htex_open_options *open) { return call(open, &scene_options, &scene); });
        if (Status status = status_of(code); !status)
            return status;
        return Scene(scene);
    }
    detail::Owned<htex_scene, htex_scene_free> handle_;
};

/* An open device, which plays samples. If it is freed before `finish` was called, it goes to
 * rest at once. [one thread at a time] */
class Device {
public:
    Device() noexcept = default;

    /* Returns the kinds of devices that the library can play on, as JSON; see
     * htex_device_list_json. */
    static Result<std::string> list_json()
    {
        return detail::text([](char *out, size_t capacity, size_t *length) {
            return htex_device_list_json(out, capacity, length);
        });
    }
    /* Returns a description of a device as JSON: its settings, the quantity of its samples, its
     * sample rates; see htex_device_info_json. */
    static Result<std::string> info_json(const std::string &name, const std::string &settings = {})
    {
        return detail::text([&](char *out, size_t capacity, size_t *length) {
            return htex_device_info_json(name.c_str(), settings.c_str(), out, capacity, length);
        });
    }
    /* Opens a device. `settings` holds lines of the form NAME=VALUE. A `rate_hz` of 0 selects
     * the device's own sample rate. */
    static Result<Device> open(const std::string &name, const std::string &settings = {}, double rate_hz = 0.0)
    {
        htex_device device{};
        if (Status status = status_of(htex_device_open(name.c_str(), settings.c_str(), rate_hz, &device)); !status)
            return status;
        return Device(device);
    }
    double rate_hz() const noexcept
    {
        double rate_hz = NAN;
        htex_device_rate_hz(handle_.get(), &rate_hz);
        return rate_hz;
    }
    /* Passes samples to the device, as many as it takes within `timeout_ms`; `written` receives
     * their number. */
    htex_status write(const float *samples, size_t frames, uint32_t timeout_ms, size_t &written) noexcept
    {
        return htex_device_write(handle_.get(), samples, frames, timeout_ms, &written);
    }
    htex_status status(DeviceCounts &counts) const noexcept
    {
        counts.size = sizeof counts;
        return htex_device_status(handle_.get(), &counts);
    }
    /* Plays all samples that were written, then brings the device to rest; see
     * htex_device_finish. */
    htex_status finish() noexcept { return htex_device_finish(handle_.get()); }

private:
    explicit Device(htex_device handle) noexcept : handle_(handle) {}
    detail::Owned<htex_device, htex_device_free> handle_;
};

} /* namespace htex */

#endif
