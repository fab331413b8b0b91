#include "motor_line.h"

#include <string.h>

static const char digits[] = "0123456789ABCDEF";

static int hex_value(char digit)
{
    const char *found = digit ? strchr(digits, digit) : NULL;
    return found ? (int)(found - digits) : -1;
}

/* Value of `count` hexadecimal digits, -1 if they are none. */
static int32_t hex_number(const char *text, int count)
{
    int32_t value = 0;
    for (int i = 0; i < count; i++) {
        int digit = hex_value(text[i]);
        if (digit < 0)
            return -1;
        value = value * 16 + digit;
    }
    return value;
}

static void put_hex(char *text, uint16_t value, int count)
{
    for (int i = count - 1; i >= 0; i--, value >>= 4)
        text[i] = digits[value & 15];
}

static uint16_t crc_of(const char *text, int length)
{
    uint16_t crc = 0xFFFF;
    for (int i = 0; i < length; i++)
        crc = motor_line_crc(crc, text[i]);
    return crc;
}

static bool begins_with(const char *text, const char *word)
{
    size_t length = strlen(word);
    return strncmp(text, word, length) == 0 && (text[length] == ' ' || text[length] == '\0');
}

/* Check the line in `text`, from its '>' to before its newline, and leave there the request alone. */
static bool unframe(struct motor_line *line)
{
    char *text = line->text;
    int length = line->length;
    if (length > 0 && text[length - 1] == '\r')
        length--;
    int star = length - 5; /* ">02 " ... "*B1BF" */
    if (star < 4 || text[0] != '>' || text[3] != ' ' || text[star] != '*')
        return false;
    for (int i = 4; i < star; i++)
        if (text[i] < ' ' || text[i] > '~' || text[i] == '*' || text[i] == '<')
            return false;
    line->number = (int16_t)hex_number(text + 1, 2);
    if (line->number < 0 || hex_number(text + star + 1, 4) != crc_of(text, star))
        return false;
    memmove(text, text + 4, (size_t)(star - 4));
    text[star - 4] = '\0';
    return true;
}

static enum motor_line_event judge(struct motor_line *line)
{
    bool begins = begins_with(line->text, "ID");
    bool stops = begins_with(line->text, "STOP");
    uint8_t ahead = (uint8_t)(line->number - line->last);

    line->is_late = line->last < 0 || ahead > 127;
    if (!begins && !stops && line->is_late)
        return MOTOR_LINE_LATE;
    if (!begins && !stops && ahead == 0)
        return MOTOR_LINE_RESEND;
    if (begins)
        line->is_late = false;
    return MOTOR_LINE_REQUEST;
}

void motor_line_init(struct motor_line *line)
{
    memset(line, 0, sizeof *line);
    line->last = -1;
}

enum motor_line_event motor_line_feed(struct motor_line *line, char byte)
{
    if (byte == '>')
        line->length = 0;
    if (byte != '\n') {
        if (line->length < MOTOR_LINE_LONGEST)
            line->text[line->length++] = byte;
        return MOTOR_LINE_NONE;
    }
    bool fits = line->length < MOTOR_LINE_LONGEST && unframe(line);
    line->length = 0;
    return fits ? judge(line) : MOTOR_LINE_NONE;
}

const char *motor_line_reply(struct motor_line *line, const char *text)
{
    char *reply = line->is_late ? line->late : line->reply;
    int length = 4;

    reply[0] = '<';
    put_hex(reply + 1, (uint16_t)line->number, 2);
    reply[3] = ' ';
    for (; *text && length < MOTOR_LINE_LONGEST - 6; text++)
        if (*text >= ' ' && *text <= '~' && !strchr("*<>", *text))
            reply[length++] = *text;
    uint16_t crc = crc_of(reply, length);
    reply[length] = '*';
    put_hex(reply + length + 1, crc, 4);
    reply[length + 5] = '\n';
    reply[length + 6] = '\0';
    if (!line->is_late)
        line->last = line->number;
    return reply;
}

bool motor_line_number(const char **text, uint32_t *value)
{
    const char *at = *text;
    uint32_t sum = 0;

    if (*at < '0' || *at > '9')
        return false;
    for (; *at >= '0' && *at <= '9'; at++) {
        uint32_t digit = (uint32_t)(*at - '0');
        if (sum > (UINT32_MAX - digit) / 10)
            return false;
        sum = sum * 10 + digit;
    }
    if (*at == ' ')
        at++;
    else if (*at)
        return false;
    *text = at;
    *value = sum;
    return true;
}

uint16_t motor_line_crc(uint16_t crc, char byte)
{
    crc ^= (uint16_t)((uint16_t)(uint8_t)byte << 8);
    for (int bit = 0; bit < 8; bit++)
        crc = (uint16_t)(crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1);
    return crc;
}
