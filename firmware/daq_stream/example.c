/* A board without a board: streams a test signal as the firmware of a real one would, for POSIX hosts.
 *
 *     example [--pty] [--rate HZ] [--channels N] [--seconds S] [--ram KIB] [--lose SCAN COUNT]
 *
 * Without --pty it writes S seconds of DATA frames to stdout at once, then a STOPPED frame. With --pty it opens a
 * pseudo terminal, prints its path and is a DAQ on it: ID?, START and STOP are obeyed, samples are taken in real time,
 * and those for which the port has no room are lost and flagged, as on hardware. It ends S seconds after it began.
 * --ram: what it has for samples that wait for the port; by default much, as this program may be kept from running
 * for longer than a board would be. --lose: take COUNT scans from SCAN on and lose them, as an overrun does.
 *
 * Channel 0 is a keyphasor, 50 pulses a second; the others count up from their own number, so that a test can tell
 * where every sample belongs.
 */
#define _XOPEN_SOURCE 600

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "daq_stream.h"

enum { CHANNELS_MAX = 32, SCANS_MAX = 600 }; /* 3 * 32 * 600 bytes and a head are within a payload */
enum { FRAMES_A_SECOND = 100 };
enum { FRAME_MAX = DAQ_DATA_BYTES(SCANS_MAX, CHANNELS_MAX) };
enum { RAM_MAX = 4096, RAM_SPARE = 64 }; /* KiB; 3.5 s of 8 channels at 50 kS/s; spare: for the answers */
enum { QUEUE_MAX = (RAM_MAX + RAM_SPARE) * 1024 };
enum { PULSES_A_SECOND = 50 };

typedef struct {
    bool pty;
    unsigned rate, channels, seconds, ram;
    uint64_t lose_from, lose_count;
} options;

typedef struct {
    options set;
    uint16_t frame_scans;
    daq_stream stream;
    daq_line line;
    bool streaming;
    int port;
    uint8_t queue[QUEUE_MAX];
    size_t queued;
    size_t under_way; /* bytes of the queue that end a frame whose beginning is sent */
    double started; /* s, when the stream began */
} board;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fail(const char *what)
{
    perror(what);
    exit(1);
}

/* The converter: one frame of the test signal from `scan` on. */
static void sample(const board *b, uint64_t scan, int32_t *counts)
{
    const unsigned turn = b->set.rate / PULSES_A_SECOND;
    for (uint16_t i = 0; i < b->frame_scans; i++, scan++) {
        for (unsigned c = 0; c < b->set.channels; c++)
            *counts++ = c ? (int32_t)((scan + c) & 0x7FFFFF) - 0x400000 : scan % turn < turn / 20 ? -5000000 : -2000000;
    }
}

/* Encode the next frame, or lose it if it is to be lost or finds no room. */
static void take_frame(board *b, size_t room)
{
    static int32_t counts[CHANNELS_MAX * SCANS_MAX];
    const uint64_t scan = b->stream.scan, end = scan + b->frame_scans;
    if (b->set.lose_count && scan <= b->set.lose_from && b->set.lose_from < end) {
        daq_stream_lose(&b->stream, b->set.lose_count);
        b->set.lose_count = 0;
        return;
    }
    if (DAQ_DATA_BYTES(b->frame_scans, b->set.channels) > room) {
        daq_stream_lose(&b->stream, b->frame_scans);
        return;
    }
    sample(b, scan, counts);
    b->queued += daq_stream_data(&b->stream, counts, b->frame_scans, b->queue + b->queued, room);
}

static size_t frame_length(const uint8_t *frame)
{
    return DAQ_FRAME_OVERHEAD + frame[4] + ((size_t)frame[5] << 8);
}

static void flush_to(int file, board *b, bool block)
{
    size_t sent = 0, ends = b->under_way;
    while (sent < b->queued) {
        const ssize_t n = write(file, b->queue + sent, b->queued - sent);
        if (n < 0 && (errno == EAGAIN || errno == EINTR) && !block)
            break;
        if (n < 0)
            fail("write");
        sent += (size_t)n;
    }
    while (ends < sent)
        ends += frame_length(b->queue + ends);
    b->under_way = ends - sent;
    memmove(b->queue, b->queue + sent, b->queued - sent);
    b->queued -= sent;
}

/* At STOP and START: drop DATA frames of which nothing is sent yet. */
static void drop_data(board *b)
{
    size_t kept = b->under_way;
    for (size_t at = kept, length; at < b->queued; at += length) {
        length = frame_length(b->queue + at);
        if (b->queue[at + 2] != 0x02) {
            memmove(b->queue + kept, b->queue + at, length);
            kept += length;
        }
    }
    b->queued = kept;
}

static size_t info(const board *b, uint8_t *out, size_t room)
{
    char json[256 + CHANNELS_MAX * 16], scales[CHANNELS_MAX * 16] = "";
    for (unsigned c = 0; c < b->set.channels; c++)
        strcat(scales, c ? ", 2.861e-6" : "2.861e-6"); /* 24 V over 2^23 counts */
    snprintf(json, sizeof json,
             "{\"protocol\": 1, \"model\": \"reference encoder\", \"serial\": \"0\", \"sample_rate_hz\": %u, "
             "\"channels\": %u, \"volts_per_count\": [%s], \"full_scale_counts\": 8388608}",
             b->set.rate, b->set.channels, scales);
    return daq_stream_info(json, out, room);
}

static void obey(board *b, daq_command command)
{
    if (command == DAQ_START || command == DAQ_STOP)
        drop_data(b);
    uint8_t *out = b->queue + b->queued;
    const size_t room = QUEUE_MAX - b->queued;
    switch (command) {
    case DAQ_NONE:
        return;
    case DAQ_ASK:
        b->queued += info(b, out, room);
        return;
    case DAQ_START:
        daq_stream_begin(&b->stream, (uint8_t)b->set.channels);
        b->streaming = true;
        b->started = now();
        return;
    case DAQ_STOP:
        b->streaming = false;
        b->queued += daq_stream_stopped(&b->stream, out, room);
        return;
    case DAQ_UNKNOWN:
        b->queued += daq_stream_error("want ID?, START or STOP", out, room);
        return;
    }
}

static void listen_to_host(board *b)
{
    char heard[64];
    const ssize_t n = read(b->port, heard, sizeof heard);
    for (ssize_t i = 0; i < n; i++)
        obey(b, daq_hear(&b->line, heard[i]));
}

/* Open a pseudo terminal in raw mode; its other side stays open here, so that hosts may come and go. */
static int open_pty(void)
{
    const int port = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    struct termios raw;
    if (port < 0 || grantpt(port) || unlockpt(port))
        fail("pty");
    const int other = open(ptsname(port), O_RDWR | O_NOCTTY);
    if (other < 0 || tcgetattr(other, &raw))
        fail("pty");
    raw.c_iflag = raw.c_oflag = raw.c_lflag = 0;
    raw.c_cflag = (raw.c_cflag & ~(tcflag_t)(CSIZE | PARENB)) | CS8;
    if (tcsetattr(other, TCSANOW, &raw))
        fail("pty");
    return port;
}

static void run_on_pty(board *b)
{
    const double until = now() + b->set.seconds;
    b->port = open_pty();
    printf("%s\n", ptsname(b->port));
    fflush(stdout);
    while (now() < until) {
        struct pollfd wait = {.fd = b->port, .events = (short)(POLLIN | (b->queued ? POLLOUT : 0)), .revents = 0};
        poll(&wait, 1, 1);
        listen_to_host(b);
        while (b->streaming && (double)(b->stream.scan + b->frame_scans) < (now() - b->started) * b->set.rate)
            take_frame(b, b->set.ram * 1024 > b->queued ? b->set.ram * 1024 - b->queued : 0);
        flush_to(b->port, b, false);
    }
}

static void run_to_stdout(board *b)
{
    daq_stream_begin(&b->stream, (uint8_t)b->set.channels);
    while (b->stream.scan < (uint64_t)b->set.rate * b->set.seconds) {
        take_frame(b, b->set.ram * 1024);
        flush_to(STDOUT_FILENO, b, true);
    }
    b->queued = daq_stream_stopped(&b->stream, b->queue, QUEUE_MAX);
    flush_to(STDOUT_FILENO, b, true);
}

static unsigned number(const char *text, unsigned long least, unsigned long most)
{
    char *end;
    const unsigned long value = strtoul(text, &end, 10);
    if (*text == '\0' || *end != '\0' || value < least || value > most) {
        fprintf(stderr, "got '%s', want a whole number from %lu to %lu\n", text, least, most);
        exit(2);
    }
    return (unsigned)value;
}

static options parsed(int argc, char **argv)
{
    options set = {.pty = false, .rate = 50000, .channels = 8, .seconds = 10, .ram = RAM_MAX, .lose_from = 0, .lose_count = 0};
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--pty")) {
            set.pty = true;
        } else if (!strcmp(argv[i], "--rate") && i + 1 < argc) {
            set.rate = number(argv[++i], FRAMES_A_SECOND, (unsigned long)SCANS_MAX * FRAMES_A_SECOND);
        } else if (!strcmp(argv[i], "--channels") && i + 1 < argc) {
            set.channels = number(argv[++i], 1, CHANNELS_MAX);
        } else if (!strcmp(argv[i], "--seconds") && i + 1 < argc) {
            set.seconds = number(argv[++i], 1, 86400);
        } else if (!strcmp(argv[i], "--ram") && i + 1 < argc) {
            set.ram = number(argv[++i], RAM_SPARE, RAM_MAX);
        } else if (!strcmp(argv[i], "--lose") && i + 2 < argc) {
            set.lose_from = number(argv[++i], 0, 1000000000);
            set.lose_count = number(argv[++i], 0, 1000000000);
        } else {
            fprintf(stderr, "got '%s', want --pty, --rate, --channels, --seconds, --ram or --lose SCAN COUNT\n", argv[i]);
            exit(2);
        }
    }
    return set;
}

int main(int argc, char **argv)
{
    static board b;
    b.set = parsed(argc, argv);
    b.frame_scans = (uint16_t)(b.set.rate / FRAMES_A_SECOND);
    if (b.set.pty)
        run_on_pty(&b);
    else
        run_to_stdout(&b);
    return 0;
}
