// Plays an asset along a stroke that speeds up, and writes the samples as 32-bit floats.
//
//     c++ -std=c++17 play.cpp $(pkg-config --cflags --libs htex) -o play
//     ./play sandpaper.htex stroke.f32
#include <cstdio>

#include <htex.hpp>

int main(int argc, char **argv)
{
    if (argc != 3) {
        std::fprintf(stderr, "usage: play ASSET.htex OUT.f32\n");
        return 2;
    }
    htex::VoiceOptions options;
    options.seed = 7;
    auto texture = htex::Texture::open(argv[1]);
    if (!texture) {
        std::fprintf(stderr, "%s: %s\n", argv[1], texture.status().text.c_str());
        return 1;
    }
    auto voice = texture->voice(options);
    if (!voice) {
        std::fprintf(stderr, "voice: %s\n", voice.status().text.c_str());
        return 1;
    }
    std::FILE *file = std::fopen(argv[2], "wb");
    if (file == nullptr) {
        std::perror(argv[2]);
        return 1;
    }
    for (int block = 0; block < 625; block++) { // 2 s at 20 kHz
        float samples[64];
        if (voice->set_motion(htex::motion(40.0 + 0.2 * block, 0.4)) != HTEX_STATUS_OK
            || voice->render(samples, 64) != HTEX_STATUS_OK) {
            std::fprintf(stderr, "render: %s\n", htex_last_error());
            return 1;
        }
        std::fwrite(samples, sizeof samples[0], 64, file);
    }
    return std::fclose(file) == 0 ? 0 : 1;
}
