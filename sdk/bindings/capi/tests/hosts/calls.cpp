// Prints what a voice, its asset and the library tell: each line is a name and its values.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include <htex.hpp>

static std::vector<uint8_t> bytes_of(const char *path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/* Writes samples of a voice to the device of many channels, and tells what it took. */
static int plays(htex::Voice &voice, const char *path)
{
    auto info = htex::Device::info_json("sdl");
    if (!info || info->find("\"mapping\"") == std::string::npos || htex::Device::open("none"))
        return 3;
    auto device = htex::Device::open("channels", std::string("to=file\npath=") + path, 48000.0);
    if (!device)
        return std::fprintf(stderr, "%s\n", device.status().text.c_str()), 4;
    std::vector<float> samples(2000);
    size_t written = 0;
    htex::DeviceCounts counts{};
    voice.set_motion(htex::motion(80.0, 0.4));
    voice.render(samples.data(), samples.size());
    if (device->write(samples.data(), samples.size(), 1000, written) || device->status(counts) || device->finish())
        return std::fprintf(stderr, "%s\n", htex_last_error()), 5;
    std::printf("device %zu %llu %.17g\n", written, static_cast<unsigned long long>(counts.frames_written), device->rate_hz());
    return device->write(samples.data(), 1, 0, written) == HTEX_STATUS_OK;
}

int main(int argc, char **argv)
{
    if (argc != 4)
        return 2;
    std::vector<uint8_t> bytes = bytes_of(argv[1]), packed = bytes_of(argv[2]);
    htex_reader reader{sizeof reader, bytes.size(), bytes.data(),
                       [](void *context, uint64_t offset, uint8_t *buffer, size_t len) -> int32_t {
                           const uint8_t *from = static_cast<const uint8_t *>(context) + offset;
                           std::copy(from, from + len, buffer);
                           return 0;
                       },
                       nullptr};
    htex::OpenOptions open;
    open.engine = htex::Engine::checked;
    auto texture = htex::Texture::open(reader, open);
    if (!texture)
        return std::fprintf(stderr, "%s\n", texture.status().text.c_str()), 1;
    auto library = htex::Library::from_bytes(packed.data(), packed.size());
    std::printf("library %d\n", static_cast<int>(*library->count()));
    std::printf("name %s\n", texture->name()->c_str());
    std::printf("level %.17g\n", *texture->level_rms());
    std::printf("band %.17g %.17g\n", texture->band()->low_hz, texture->band()->high_hz);
    htex::VoiceOptions options;
    options.seed = 7;
    options.gain = 0.5;
    options.limit = 0.01;
    options.envelope_bands = 3;
    options.fluctuation = true;
    auto voice = texture->voice(options);
    std::printf("model %s\n", voice->model()->c_str());
    std::vector<float> samples(4000), sum(4000);
    htex::Envelope envelope;
    double bands[3];
    if (voice->render(samples.data(), samples.size()) || voice->envelope(envelope, bands, 3))
        return 1;
    std::printf("envelope %.17g %.17g %.17g %.17g %.17g\n", envelope.level_rms, envelope.centroid_hz, bands[0],
                bands[1], bands[2]);
    std::printf("edges %.17g %.17g\n", (*voice->envelope_edges(3))[1], (*voice->envelope_edges(3))[2]);
    if (voice->set_gain(-1.0) != HTEX_STATUS_INVALID_ARGUMENT || !voice->reset()
        || voice->render_add(sum.data(), sum.size(), 1.0f))
        return 1;
    std::printf("again %d\n", samples == sum);
    voice->set_motion(htex::motion(0.0, 0.0));
    voice->render(samples.data(), samples.size());
    std::printf("silent %d\n", voice->is_silent());
    std::printf("status %s\n", htex::text_of(HTEX_STATUS_BUSY));
    if (int failed = plays(*voice, argv[3]))
        return failed;
    return htex::shutdown();
}
